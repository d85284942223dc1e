"""Makes `catalogue.json` from a list of CARLA's blueprints.

Usage: python -m tools.carla_catalogue ASSETS.json [-o catalogue.json]

The list names blueprints with sizes and versions, weather parameters and towns (README.md states its
source). This script adds plain-language descriptions, the names of the same things in other catalogues,
two overturned vehicles, the state of the towns' traffic lights, and physical values for what CARLA gives
in percent.
"""

import argparse
import json
from pathlib import Path
from typing import Any

SHIPPED = Path(__file__).parents[1] / "adapters" / "oodscen_carla" / "catalogue.json"
VERSION = "0.9.16"
EGO = "vehicle.lincoln.mkz_2020"
LIGHTS = ["off", "brake", "hazard", "indicate_left", "indicate_right"]

CATEGORIES = {"walker": "pedestrian", "vehicle": "vehicle", "prop": "object"}
"""Category by kind of blueprint, unless the tables below override it."""
WORK_ZONE = {"cone", "barrier", "trafficwarning"}
"""CARLA's categories of props that belong to road works."""
KNOWN_AS = {
    "car": ["car"],
    "van": ["van"],
    "truck": ["truck"],
    "bus": ["bus"],
    "motorcycle": ["motorcycle"],
    "bicycle": ["cyclist"],
    "box": ["cardboard_box"],
    "plantpot": ["plant_pot"],
    "cone": ["cone"],
    "barrel": ["barrel"],
    "debris": ["debris"],
    "table": ["table"],
    "chair": ["chair"],
    "trash": ["bin"],
    "container": ["waste_container"],
}
"""Names in other catalogues, by CARLA's category."""
SAME_AS = {
    "static.prop.chainbarrier": [],
    "static.prop.chainbarrierend": [],
    "static.prop.haybale": ["hay_bale"],
    "static.prop.haybalelb": ["hay_bale"],
    "static.prop.ironplank": ["metal_sheet", "road_plate"],
    "static.prop.maptable": [],
    "static.prop.plasticbag": ["plastic_bag"],
    "static.prop.shoppingcart": ["shopping_cart"],
    "static.prop.streetbarrier": ["barrier"],
    "static.prop.trafficwarning": ["arrow_board"],
    "static.prop.trampoline": ["trampoline"],
    "static.prop.travelcase": ["suitcase"],
    "static.prop.warningconstruction": ["road_works_sign"],
    "vehicle.jeep.wrangler_rubicon": ["suv", "car"],
    "vehicle.nissan.patrol": ["suv", "car"],
    "vehicle.nissan.patrol_2021": ["suv", "car"],
    "vehicle.tesla.cybertruck": ["pickup"],
}
"""Names in other catalogues, by blueprint."""
SPECIAL = {
    "police": "police_car",
    "ambulance": "ambulance",
    "firetruck": "fire_truck",
    "taxi": "taxi",
}
"""Names in other catalogues, by CARLA's attribute `special_type`."""
LOOKS = {
    "advertisement": "an advertising panel on the pavement",
    "aporosatree": "a standing broad-leaved tree",
    "atm": "a cash machine",
    "barbeque": "a barbecue",
    "barrel": "a steel drum",
    "bench": "a bench",
    "bike helmet": "a bicycle helmet",
    "bin": "a rubbish bin",
    "box": "a brown cardboard box",
    "briefcase": "a briefcase",
    "brokentile": "a piece of a broken tile",
    "busstop": "a bus shelter",
    "busstoplb": "a bus shelter, turned",
    "calibrator": "a colour calibration board",
    "chainbarrier": "two posts with a chain",
    "chainbarrierend": "the end post of a chain",
    "clothcontainer": "a collecting container for clothes",
    "clothesline": "a clothes line with laundry",
    "coconutpalm": "a standing palm tree",
    "colacan": "a drinks can",
    "constructioncone": "a small traffic cone",
    "container": "a waste container",
    "creasedbox": "a crushed cardboard box",
    "cypresstree": "a standing cypress",
    "dirtdebris": "a low heap of dirt and rubble",
    "doghouse": "a dog kennel",
    "foodcart": "a food stall",
    "fountain": "a large fountain",
    "garbage": "a piece of litter",
    "gardenlamp": "a garden lamp",
    "glasscontainer": "a bottle bank",
    "gnome": "a garden gnome",
    "guitarcase": "a guitar case",
    "haybale": "a bale of straw",
    "haybalelb": "a bale of straw, turned",
    "ironplank": "a flat iron plate",
    "kiosk_": "a kiosk",
    "mailbox": "a letter box",
    "maptable": "a stand with a map",
    "mobile": "a mobile phone",
    "motorhelmet": "a motorcycle helmet",
    "pergola": "a wooden pergola",
    "plantpot": "a pot with a plant",
    "plasticbag": "a plastic bag",
    "plasticchair": "a plastic chair",
    "plastictable": "a plastic table with a parasol",
    "platformgarbage": "a spread of rubbish",
    "purse": "a handbag",
    "shoppingbag": "a shopping bag",
    "shoppingcart": "a supermarket trolley",
    "shoppingtrolley": "a two-wheeled shopping bag",
    "slide": "a playground slide",
    "streetbarrier": "a road barrier",
    "streetfountain": "a drinking fountain",
    "streetsign": "a street sign on a post",
    "swing": "a playground swing",
    "swingcouch": "a garden swing seat",
    "table": "a table",
    "trafficcone": "a traffic cone",
    "trafficwarning": "a trailer with a large warning arrow",
    "trampoline": "a garden trampoline",
    "trashbag": "a bag of rubbish",
    "trashcan": "a rubbish bin",
    "travelcase": "a suitcase",
    "vendingmachine": "a vending machine",
    "warningaccident": "a warning sign for an accident",
    "warningconstruction": "a warning sign for road works",
    "wateringcan": "a watering can",
}
"""Description by the last part of a prop's id, without its number."""
VEHICLES = {
    "bicycle": "a person riding a bicycle",
    "motorcycle": "a motorcycle with its rider",
    "police": "a police car",
    "ambulance": "an ambulance",
    "firetruck": "a fire engine",
    "taxi": "a taxi",
    "vehicle.carlamotors.carlacola": "a small delivery lorry",
    "vehicle.carlamotors.european_hgv": "a lorry with a box body",
    "vehicle.tesla.cybertruck": "an angular pickup truck",
    "vehicle.mitsubishi.fusorosa": "a bus",
    "vehicle.mercedes.sprinter": "a delivery van",
    "vehicle.micro.microlino": "a tiny two-seat car",
}
POSES: tuple[tuple[str, str, str, str], ...] = (
    ("vehicle.nissan.patrol", "roof", "overturned_car", "an off-road car lying on its roof"),
    ("vehicle.carlamotors.european_hgv", "side", "overturned_truck", "a lorry lying on its side"),
)
"""Blueprint, resting side, name in other catalogues, description: any blueprint can be spawned rolled over."""

Town = tuple[str, str, str, int, int, float, tuple[str, ...]]
TOWNS: tuple[Town, ...] = (
    ("Town01", "Town01", "a small town with a river and bridges", 1, 1, 8.3,
     ("residential", "two_lane", "oncoming", "junction", "t_junction", "bridge", "signalised")),
    ("Town02", "Town02", "a small town with homes and shops", 1, 1, 8.3,
     ("residential", "two_lane", "oncoming", "junction", "t_junction", "signalised")),
    ("Town03", "Town03", "a large town with a roundabout, a wide junction and a tunnel", 2, 2, 11.1,
     ("urban", "four_lane", "oncoming", "junction", "signalised", "roundabout", "tunnel")),
    ("Town04-highway", "Town04", "a motorway that loops in a figure of eight", 4, 0, 25.0,
     ("highway", "divided", "shoulder")),
    ("Town04-town", "Town04", "a small mountain town", 1, 1, 8.3,
     ("rural", "mountain", "two_lane", "oncoming", "junction", "signalised")),
    ("Town05", "Town05", "a grid of city streets with several lanes, and a bridge", 2, 2, 11.1,
     ("urban", "four_lane", "oncoming", "junction", "signalised", "bridge")),
    ("Town06", "Town06", "long motorways of many lanes with entries and exits", 4, 0, 25.0,
     ("highway", "divided", "shoulder")),
    ("Town07", "Town07", "narrow country roads with barns and hardly any lights", 1, 1, 8.3,
     ("rural", "two_lane", "oncoming", "curve", "junction", "t_junction")),
    ("Town10HD", "Town10HD", "a city centre of tall buildings with a promenade by the sea", 2, 2, 8.3,
     ("urban", "four_lane", "oncoming", "junction", "signalised", "coastal")),
    ("Town12-residential", "Town12", "a residential district of a very large map", 1, 1, 8.3,
     ("residential", "two_lane", "oncoming", "junction")),
    ("Town12-rural", "Town12", "country roads of a very large map", 1, 1, 16.7,
     ("rural", "two_lane", "oncoming")),
)  # fmt: skip
"""Id, CARLA's name, description, lanes in the ego's direction and against it, speed (m/s), traits."""
MARKS = {
    "junction": "junction",
    "roundabout": "roundabout",
    "tunnel": "tunnel",
    "bridge": "bridge",
    "signalised": "traffic_light",
}
"""Landmarks implied by traits."""
WEATHER = {
    "min_sun_elevation_deg": -90.0,
    "min_fog_visual_range_m": 20.0,
    "precipitation": ["none", "rain"],
    "max_precipitation_mm_h": 50.0,
    "min_friction": 0.1,
    "others": ["dust", "wind"],
}
"""Weather limits. Fog and rain are percentages in CARLA: full fog counts as 20 m visual range, full
rain as 50 mm/h. `static.trigger.friction` sets friction. No parameter makes snow."""


def catalogue(listed: dict[str, Any]) -> dict[str, Any]:
    """Return the catalogue without the behaviours, which all adapters share.

    Raises:
        KeyError: If the list lacks a part, or has no blueprint of the version.
        ValueError: If a required town or weather parameter is not in the list.
    """
    rows = {row["id"]: row for row in listed["assets"] if VERSION in row["versions"]}
    parameters = {row["name"] for row in listed["weather_parameters"]}
    for needed in ("fog_density", "precipitation", "sun_altitude_angle", "dust_storm"):
        if needed not in parameters:
            raise ValueError(f"the list has no weather parameter {needed!r}")
    if any("snow" in name.casefold() for name in parameters):
        raise ValueError("this CARLA has snow: give it a place in WEATHER")
    absent = {town for _, town, *_ in TOWNS} - set(listed["maps"])
    if absent:
        raise ValueError(f"the list has no {', '.join(sorted(absent))}")
    ego = _asset(rows[EGO])
    assets = [_asset(row) for row in rows.values()]
    assets += [_turned(rows[blueprint], *rest) for blueprint, *rest in POSES]
    assets.append(
        {
            "id": "traffic.traffic_light",
            "category": "signal",
            "description": "a traffic light, there where the town has one",
            "length": 0.6,
            "width": 0.6,
            "height": 4.0,
            "tags": ["part_of_the_town"],
            "states": ["red", "amber", "green", "off"],
            "names": ["traffic_light"],
        }
    )
    return {
        "simulator": "carla",
        "version": VERSION,
        "ego": {**ego, "description": "the vehicle under test: a saloon car", "names": []},
        "assets": sorted(assets, key=lambda asset: asset["id"]),
        "maps": [_map(*town) for town in TOWNS],
        "weather": WEATHER,
    }


def _asset(row: dict[str, Any]) -> dict[str, Any]:
    kind, group, name = row["kind"], row["category"], row["id"]
    category = CATEGORIES[kind]
    if group == "bicycle":
        category = "cyclist"
    elif group in WORK_ZONE or "construction" in row.get("ood_roles", ()):
        category = "work_zone"
    elif "haybale" in name or name.endswith(("tree", "palm")):
        category = "vegetation"
    size = row["size_m"]
    return {
        "id": name,
        "category": category,
        "description": _look(row),
        **{side: size[side] for side in ("length", "width", "height")},
        "tags": [group],
        "states": _states(row),
        "names": _names(row),
    }


def _names(row: dict[str, Any]) -> list[str]:
    if row["kind"] == "walker":
        if row.get("role") == "police":
            return ["police_officer"]
        return ["child" if row.get("age") == "child" else "adult"]
    if row.get("special") in SPECIAL:
        return [SPECIAL[row["special"]]]
    return SAME_AS.get(row["id"], KNOWN_AS.get(row["category"], []))


def _states(row: dict[str, Any]) -> list[str]:
    if row["kind"] != "vehicle" or row["category"] == "bicycle":
        return []
    has_beacon = row.get("special") in ("police", "ambulance", "firetruck")
    return [*LIGHTS, "beacon"] if has_beacon else LIGHTS


def _look(row: dict[str, Any]) -> str:
    name = row["id"]
    if row["kind"] == "walker":
        if row.get("role") == "police":
            return "a police officer on foot"
        return f"{'a child' if row.get('age') == 'child' else 'an adult'} on foot"
    if row["kind"] == "vehicle":
        make = " ".join(name.split(".")[1:]).replace("_", " ").replace("-", " ")
        for key in (name, row.get("special"), row["category"]):
            if key in VEHICLES:
                return f"{VEHICLES[key]} ({make})"
        kind = {"car": "a passenger car", "van": "a van", "truck": "a lorry"}
        return f"{kind[row['category']]} ({make})"
    return LOOKS[name.removeprefix("static.prop.").rstrip("0123456789")]


def _turned(row: dict[str, Any], rests_on: str, name: str, look: str) -> dict[str, Any]:
    """Return a vehicle lying on its roof or on its side."""
    asset = _asset(row)
    if rests_on == "side":
        asset = {**asset, "width": asset["height"], "height": asset["width"]}
    return {
        **asset,
        "id": f"{row['id']}@{rests_on}",
        "description": look,
        "tags": [row["category"], "turned"],
        "names": [name],
    }


def _map(
    name: str,
    town: str,
    look: str,
    lanes: int,
    oncoming: int,
    speed: float,
    traits: tuple[str, ...],
) -> dict[str, Any]:
    return {
        "id": name,
        "description": f"{look} ({town})",
        "file": "",
        "lanes": lanes,
        "oncoming_lanes": oncoming,
        "has_shoulder": "shoulder" in traits,
        "speed_limit": speed,
        "length_m": 500.0,
        "traits": list(traits),
        "landmarks": [mark for trait, mark in MARKS.items() if trait in traits],
    }


def main() -> None:
    """Read the list and write the catalogue."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("assets", type=Path)
    parser.add_argument("-o", "--out", type=Path, default=SHIPPED)
    options = parser.parse_args()
    made = catalogue(json.loads(options.assets.read_text(encoding="utf-8")))
    options.out.write_text(json.dumps(made, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
