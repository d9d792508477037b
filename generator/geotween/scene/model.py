"""What a scene file may say: its model, and what each word of it means."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, WithJsonSchema, model_validator

from geotween.scene.values import (
    Colour,
    Graticule,
    Legend,
    Offset,
    Pixels,
    Place,
    Polygons,
    Positive,
    Seconds,
    Share,
    Simplify,
    StepTime,
    Text,
    Threshold,
    Tooltip,
    Transition,
)

Easing = Literal["linear", "ease", "ease-in", "ease-out", "ease-in-out"]
Period = Literal["year", "quarter", "month", "week", "day", "hour"]
ADDRESS = r"^https?://[^\s<>\"']+$"
Address = Annotated[str, Field(pattern=ADDRESS, max_length=2000)]
Speed = Annotated[float, Field(gt=0, le=100, allow_inf_nan=False)]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, validate_by_name=False)


def _file_alone(value: Any) -> Any:
    return {"file": value} if isinstance(value, str) else value


class Source(_Part):
    """A file of polygons: which of its layers and features are meant, and its columns."""

    file: Text = Field(description="relative to the scene; a .zip may hold a Shapefile")
    layer: Text | None = Field(None, description="of a GeoPackage or KML; the object of a TopoJSON")
    key: Text | None = Field(None, description="column: what is the same thing over time")
    class_: Text | None = Field(None, alias="class", description="column: what decides the colour")
    name: Text | None = Field(None, description="column: what a feature is called")
    where: Text | None = Field(None, description="SQL expression over the columns (SQLite)")
    encoding: Text | None = Field(None, description="such as latin-1, where it is not UTF-8")
    crs: Text | None = Field(None, description="such as EPSG:4326, where the file names none")


class Data(Source):
    """All steps at once: a file with a column of times, or a folder or glob of files."""

    time: Text | None = Field(None, description="column; else the time is in the files' names")
    times: tuple[Text, ...] | None = Field(
        None,
        description="times to keep, or periods: 2020, 2020-09, or 2020-09-01/2020-09-14",
        min_length=2,
    )
    time_format: Text | None = Field(None, description="of the column, as strptime takes it")


class Hotspots(_Part):
    """Points with times, as areas where they are dense."""

    file: Text = Field(description="a .csv, relative to the scene")
    x: Text | None = Field(None, description="column, with y: planar coordinates")
    y: Text | None = None
    lon: Text | None = Field(None, description="column, with lat: longitude in degrees")
    lat: Text | None = None
    time: Text = Field(description="column")
    time_format: Text | None = Field(None, description="of the column, as strptime takes it")
    period: Period | None = Field(None, description="what makes a step; else each distinct time")
    bandwidth: Positive | None = Field(
        None, description="of the Gaussian kernel, in map units: metres where there are lon and lat"
    )
    threshold: Threshold | None = Field(
        None, description="points per square map unit (km² with lon, lat), or of the peak: 20%"
    )
    levels: tuple[Threshold, ...] | None = Field(
        None, description="several thresholds, each a class", min_length=1
    )
    where: Text | None = Field(None, description="SQL expression over the columns (SQLite)")
    encoding: Text | None = None
    crs: Text | None = Field(None, description="of x and y")

    @model_validator(mode="after")
    def _one_pair_and_one_kind(self) -> Self:
        pairs = [(self.x, self.y), (self.lon, self.lat)]
        if [pair for pair in pairs if any(pair)] != [pair for pair in pairs if all(pair)] or all(
            map(any, pairs)
        ):
            raise ValueError("name the columns x and y, or lon and lat")
        if not any(map(any, pairs)):
            raise ValueError("name the columns of the coordinates: x and y, or lon and lat")
        if self.threshold is not None and self.levels is not None:
            raise ValueError("name a threshold or levels, not both")
        if self.levels and len({isinstance(level, str) for level in self.levels}) > 1:
            raise ValueError("levels are all shares of the peak, or none is")
        return self


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
    """Static shapes under the regions, or above them."""

    name: Text = ""
    polygons: Polygons
    fill: Colour = "#e4e1da"
    stroke: Colour = "none"
    width: Pixels = 0.75
    opacity: Share = 1.0
    above: bool = Field(False, description="drawn over the regions, not under them")


class Annotation(_Part):
    """Words at a place of the map, with a line that leads there."""

    text: Text
    at: Place
    steps: tuple[Text, ...] | None = Field(
        None, description="labels of the steps that show it; all unless given", min_length=1
    )
    offset: Offset | None = Field(
        None, description="px from the place to the words, right and down; found unless given"
    )


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
    projection: Text = Field(
        "auto",
        description="auto, an EPSG code or PROJ string, or none: coordinates are drawn as they are",
    )
    crs: Text | None = Field(
        None, description="of coordinates written in the scene, and of files that name none"
    )
    simplify: Simplify = Field(
        0.25, description="px by which a line may be off; off keeps every vertex"
    )
    min_area: Annotated[float, Field(ge=0, allow_inf_nan=False)] = Field(
        0.0, description="px²; smaller parts and holes are left out"
    )
    clean: bool = Field(False, description="close gaps and overlaps along common borders")
    classes: Literal["auto", "layers", "together"] = Field(
        "auto", description="layers: each class moves on its own; auto: where classes overlap"
    )
    class_order: tuple[Text, ...] = Field(
        (), description="the order that classes are drawn in, the lowest first"
    )
    layers: tuple[Layer, ...] = ()
    labels: Text = Field(
        "auto",
        description="on regions: none, names, keys, or a column; auto: names, where they are few",
    )
    legend: Legend = Field(
        "auto",
        description="auto: classes and static layers with names; none; or words for each of some",
    )
    unit: Literal["m", "km"] | None = Field(
        None, description="of planar coordinates, where nothing else tells how long they are"
    )
    scale_bar: Annotated[
        Literal["auto", "true", "false"], WithJsonSchema({"enum": ["auto", True, False]})
    ] = Field(
        "auto",
        description="auto: where lengths are known and the scale is nearly the same all over",
    )
    graticule: Graticule = Field(
        "none", description="meridians and parallels: auto, none, or the degrees between them"
    )
    annotations: tuple[Annotation, ...] = ()
    tooltip: Tooltip = Field(
        "auto", description="below a region's name: auto (class and columns), none, or the columns"
    )

    @model_validator(mode="after")
    def _room_for_the_data(self) -> Self:
        smaller = min(self.width, self.height or self.width)
        if 2 * self.padding >= smaller:
            raise ValueError(f"a padding of {self.padding:g} px leaves no room for the map")
        return self


class MotionRule(_Part):
    """The motion of a layer, a class or a key that is to differ from the rest."""

    method: Literal["auto", "morph", "front"]


class Motion(_Part):
    """How polygons become those of the next step; a name left out follows from the method."""

    method: Literal["auto", "morph", "front", "paper"] = Field(
        "auto", description="auto: what changes in place is swept (front), what travels morphs"
    )
    by_layer: dict[Text, MotionRule] = Field(default={}, alias="layer")
    by_class: dict[Text, MotionRule] = Field(default={}, alias="class")
    by_key: dict[Text, MotionRule] = Field(default={}, alias="key")
    annexation: Literal["sweep", "in-place"] | None = Field(
        None, description="how a front takes over a neighbour as a whole"
    )
    correspondence: Literal["intersects", "overlap", "within", "key", "auto"] | None = None
    radius: Positive | None = Field(
        None, description="of correspondence: within, in units of the map"
    )
    division: Literal["territory", "voronoi", "advancing-front", "quadtree"] | None = Field(
        None, description="what cuts a polygon for its correspondents; territory: their own areas"
    )
    matching: Literal["rotation", "trajectory"] | None = None
    path: Literal["straight", "rigid", "intrinsic"] | None = Field(
        None, description="the way of matched vertices: rigid turns shapes, intrinsic unrolls them"
    )
    easing: Easing = "ease-in-out"
    ghost: Literal["none", "origin"] = Field(
        "none", description="origin keeps the origin's outline during the transition"
    )

    @model_validator(mode="after")
    def _radius_where_it_belongs(self) -> Self:
        if (self.correspondence == "within") != (self.radius is not None):
            raise ValueError("correspondence: within and a radius belong together")
        return self


class Timing(_Part):
    """How long things take, in seconds."""

    transition: Transition = 2.0
    total: Seconds | None = Field(
        None, description="of all transitions together, where they are proportional to real time"
    )
    hold: Seconds = Field(1.0, description="rest at each step")
    loop: bool = True
    speed: Speed = 1.0


class Story(_Part):
    """How captions and the text alternative speak of what happens."""

    noun: Text | None = Field(None, description="what one of the things is called: fire")
    nouns: Text | None = Field(None, description="what several are called: fires")
    words: Text | None = Field(
        None, description="a .yaml file of other wording; see docs/events.md"
    )


class Step(_Part):
    """The polygon set at one time."""

    label: Text | None = None
    time: StepTime | None = None
    caption: Text = ""
    hold: Seconds | None = None
    polygons: Polygons = Field(None, description="needed unless data or hotspots has them")


class SceneFile(_Part):
    """A scene: polygon sets at successive times, and how they become a map that moves."""

    title: Text
    subtitle: Text = ""
    description: Text = Field("", description="text alternative: what the map shows, in words")
    source: Text = ""
    credit: Text = ""
    layout: Literal["player", "scroll"] = Field(
        "player", description="scroll: the map stays in sight and plays as captions pass by it"
    )
    url: Address | None = Field(
        None, description="of the folder where the page will stand; for social cards and oEmbed"
    )
    lang: Annotated[str, Field(pattern=r"^[A-Za-z]{2,8}(-[A-Za-z0-9]{1,8})*$")] = "en"
    map: Map = Map()
    style: Style = Style()
    motion: Motion = Motion()
    timing: Timing = Timing()
    story: Story = Story()
    data: Annotated[Data, BeforeValidator(_file_alone)] | None = None
    hotspots: Hotspots | None = None
    steps: tuple[Step, ...] = Field(
        (), description="at least two; with data or hotspots: words for their steps"
    )
