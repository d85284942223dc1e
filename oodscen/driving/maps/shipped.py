"""What the shipped maps are, for every catalogue that offers them."""

from oodscen.catalogue import RoadMap

START_M = 200.0
"""Where the ego starts on each of them."""

SHIPPED_MAPS: tuple[RoadMap, ...] = (
    RoadMap(
        id="residential_two_lane",
        description="a two-lane residential street with parked cars, pavements and a bend far ahead",
        file="oodscen.driving:maps/residential_two_lane.xodr",
        start_m=START_M,
        lanes=1,
        oncoming_lanes=1,
        speed_limit=8.33,
        length_m=600.0,
        traits=("residential", "two_lane", "oncoming"),
    ),
    RoadMap(
        id="urban_three_lane",
        description="a straight one-way city street with three lanes and pavements",
        file="oodscen.driving:maps/urban_three_lane.xodr",
        start_m=START_M,
        lanes=3,
        speed_limit=13.9,
        length_m=780.0,
        traits=("urban", "three_lane", "one_way"),
    ),
    RoadMap(
        id="urban_avenue",
        description="a city avenue with two lanes each way and pavements",
        file="oodscen.driving:maps/urban_avenue.xodr",
        start_m=START_M,
        lanes=2,
        oncoming_lanes=2,
        speed_limit=13.9,
        length_m=780.0,
        traits=("urban", "four_lane", "oncoming"),
    ),
    RoadMap(
        id="highway",
        description="a divided highway with two lanes and a hard shoulder each way",
        file="oodscen.driving:maps/highway.xodr",
        start_m=START_M,
        lanes=2,
        oncoming_lanes=2,
        has_shoulder=True,
        speed_limit=27.8,
        length_m=1380.0,
        traits=("highway", "shoulder", "divided"),
    ),
    RoadMap(
        id="rural_curve",
        description="a two-lane country road with narrow gravel shoulders that bends to the left",
        file="oodscen.driving:maps/rural_curve.xodr",
        start_m=START_M,
        lanes=1,
        oncoming_lanes=1,
        has_shoulder=True,
        speed_limit=22.2,
        length_m=880.0,
        traits=("rural", "two_lane", "oncoming", "curve"),
    ),
)
"""Each leaves 200 m behind the ego's start."""
