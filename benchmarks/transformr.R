# Times transformr: two files of x and y, one vertex a line; prints the ms that it takes to prepare
# two frames of the motion from one polygon to the other, the second time that it does so.
library(transformr)

polygon <- function(name) {
  ring <- read.table(name, col.names = c("x", "y"))
  ring$id <- 1
  ring
}
files <- commandArgs(trailingOnly = TRUE)
from <- polygon(files[1])
to <- polygon(files[2])
for (run in 1:2) {
  spent <- system.time(tween_polygon(from, to, "linear", 2))[["elapsed"]]
}
cat(1000 * spent, "\n")
