from hypothesis import given
from hypothesis import strategies as st

from oodscen.interchange._reading.positions import EntityPlace, StraightRoad

LANES = st.integers(-5, 5).filter(bool)
POSES = st.builds(EntityPlace, *[st.floats(-100.0, 100.0)] * 2, st.floats(-3.0, 3.0))


@given(LANES, LANES, st.sampled_from([1, -1]))
def test_the_lane_beside_is_that_many_lanes_away(lane, other, direction):
    place = EntityPlace(0.0, 0.0, 0.0, "1", lane, 0.0, direction)
    lanes = place.lanes_to(other)
    assert place.lane_beside(lanes * direction) == other
    assert place.lane_beside(0) == lane


@given(POSES, st.floats(-50.0, 50.0), st.floats(-50.0, 50.0))
def test_a_moved_pose_is_at_that_offset(pose, ahead, left):
    found = pose.moved(ahead, left).offset_from(pose)
    assert all(abs(a - b) < 1e-9 for a, b in zip(found, (ahead, left), strict=True))


@given(LANES, st.booleans(), st.floats(0.0, 500.0))
def test_traffic_of_a_straight_road_keeps_to_its_side(lane, is_left_hand, s):
    place = StraightRoad(is_left_hand=is_left_hand).at(None, "1", s, lane, 0.0)
    is_kerb_side = (lane > 0) is is_left_hand
    assert place.direction == (1 if is_kerb_side else -1)
    assert place.y * lane > 0.0
