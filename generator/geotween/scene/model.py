"""What a scene file may say: its model, and what each word of it means."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from geotween.scene.values import (
    Colour,
    Pixels,
    Polygons,
    Seconds,
    Share,
    StepTime,
    Text,
    Transition,
)

Easing = Literal["linear", "ease", "ease-in", "ease-out", "ease-in-out"]
Speed = Annotated[float, Field(gt=0, le=100, allow_inf_nan=False)]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, validate_by_name=False)


class StyleRule(_Part):
    """How regions are drawn; what is left out comes from the rule above it."""

    fill: Colour | None = None
    stroke: Colour | None = None
    width: Pixels | None = Field(None, description="width of the stroke, in px of the map")
    opacity: Share | None = None


class Style(StyleRule):
    """The style of all regions, and of those of a class or a key."""

    by_class: dict[Text, StyleRule] = Field(default={}, alias="class")
    by_key: dict[Text, StyleRule] = Field(default={}, alias="key")


class Layer(_Part):
    """Static shapes under the regions."""

    name: Text = ""
    polygons: Polygons
    fill: Colour = "#e4e1da"
    stroke: Colour = "none"
    width: Pixels = 0.75
    opacity: Share = 1.0


class Map(_Part):
    """The frame that the map is drawn into."""

    width: Annotated[float, Field(ge=50, le=10_000, allow_inf_nan=False)] = 960
    height: Annotated[float, Field(ge=50, le=10_000, allow_inf_nan=False)] | None = Field(
        None, description="px; follows from the data unless given"
    )
    padding: Pixels = 16
    background: Colour = "#ffffff"
    fit: Literal["shared", "each"] = Field(
        "shared", description="one frame for all steps, or every step centred in the same frame"
    )
    y: Literal["up", "down"] = "up"
    layers: tuple[Layer, ...] = ()

    @model_validator(mode="after")
    def _room_for_the_data(self) -> Self:
        smaller = min(self.width, self.height or self.width)
        if 2 * self.padding >= smaller:
            raise ValueError(f"a padding of {self.padding:g} px leaves no room for the map")
        return self


class Motion(_Part):
    """How polygons become those of the next step; a name left out follows from the method."""

    method: Literal["auto", "paper"] = "auto"
    correspondence: Literal["intersects", "key"] | None = None
    division: Literal["voronoi"] | None = None
    matching: Literal["rotation"] | None = None
    easing: Easing = "ease-in-out"
    ghost: Literal["none", "origin"] = Field(
        "none", description="origin keeps the origin's outline during the transition"
    )


class Timing(_Part):
    """How long things take, in seconds."""

    transition: Transition = 2.0
    total: Seconds | None = Field(
        None, description="of all transitions together, where they are proportional to real time"
    )
    hold: Seconds = Field(1.0, description="rest at each step")
    loop: bool = True
    speed: Speed = 1.0


class Step(_Part):
    """The polygon set at one time."""

    label: Text | None = None
    time: StepTime | None = None
    caption: Text = ""
    hold: Seconds | None = None
    polygons: Polygons


class SceneFile(_Part):
    """A scene: polygon sets at successive times, and how they become a map that moves."""

    title: Text
    subtitle: Text = ""
    description: Text = Field("", description="text alternative: what the map shows, in words")
    source: Text = ""
    credit: Text = ""
    lang: Annotated[str, Field(pattern=r"^[A-Za-z]{2,8}(-[A-Za-z0-9]{1,8})*$")] = "en"
    map: Map = Map()
    style: Style = Style()
    motion: Motion = Motion()
    timing: Timing = Timing()
    steps: Annotated[tuple[Step, ...], Field(min_length=2)]
