"""One question of every kind, with every field filled."""

from oodscen.data._claim import Claim
from oodscen.data._messages import Image
from oodscen.data._scene import Visible
from oodscen.prompts._digest import AssetLine, BehaviourLine, CatalogueDigest, MapLine
from oodscen.prompts._judging.choose_action import ActionOption, ChooseAction
from oodscen.prompts._judging.choose_aspect import ChooseAspect
from oodscen.prompts._judging.describe_frame import DescribeFrame
from oodscen.prompts._judging.drive_facts import DriveFacts
from oodscen.prompts._judging.judge_aspect import JudgeAspect
from oodscen.prompts._judging.name_aspect import NameAspect
from oodscen.prompts._judging.name_ood_aspect import NameOodAspect
from oodscen.prompts._landmarks import Landmark
from oodscen.prompts._scenario.describe_ordinary import DescribeOrdinary
from oodscen.prompts._scenario.describe_path import DescribePath
from oodscen.prompts._scenario.design_motion import DesignMotion
from oodscen.prompts._scenario.design_prop import DesignProp, KnownPart
from oodscen.prompts._scenario.estimate_rarity import EstimateRarity
from oodscen.prompts._scenario.extract_claims import ExtractClaims
from oodscen.prompts._scenario.mark_hazard import ActorLine, MarkHazard
from oodscen.prompts._scenario.recognise_prop import RecogniseProp
from oodscen.prompts._scenario.stage_scene import StageScene
from oodscen.prompts._tree.classify_examples import ClassifyExamples
from oodscen.prompts._tree.give_examples import GiveExamples
from oodscen.prompts._tree.imagine_scenario import ImagineScenario
from oodscen.prompts._tree.judge_branch import JudgeBranch, JudgeBranches
from oodscen.prompts._tree.place_scenario import Hidden, PlaceScenario
from oodscen.prompts._tree.propose_tree import ProposeTree
from oodscen.tree._scenario_tree import Node

DIGEST = CatalogueDigest(
    assets=(
        AssetLine(id="car", category="vehicle", description="a car", states=("off", "brake")),
        AssetLine(id="deer", category="animal", description="a deer"),
    ),
    behaviours=(
        BehaviourLine(
            id="bolt", description="runs", categories=("animal",), parameters="speed 1..15 (8)"
        ),
    ),
    maps=(
        MapLine(
            id="avenue",
            description="an avenue",
            lanes=2,
            oncoming_lanes=1,
            speed_limit=13.9,
            traits=("urban",),
            landmarks=(
                Landmark(kind="tunnel", ahead_m=60.5, length_m=200.0),
                Landmark(kind="traffic_light", ahead_m=90.5, left_m=-2.5),
            ),
            layout="pavement -4.7 to -1.7",
        ),
    ),
    weather="no night; no fog",
    poses=("kneel", "wave_on"),
    parts=("bonnet_open", "dirty"),
)

NODES = (
    Node(id="root", parent=None, label="Out of distribution"),
    Node(id="environmental", parent="root", label="Environmental"),
    Node(id="interactional", parent="root", label="Interactional"),
    Node(id="animals", parent="interactional", label="Animals"),
    Node(id="deer", parent="animals", label="Deer on the road"),
)

FRAMES = tuple(Image(name=f"{name}.jpg", sha256=f"{name:0<64}") for name in ("a", "b", "c"))
FACTS = DriveFacts(
    times_s=(0.0, 1.5, 3.0),
    ego_speed_mps=13.9,
    shows_decision=False,
    behind="a lorry",
    gap_m=9.5,
    follower_speed_mps=14.2,
)
REAR = Image(name="rear.jpg", sha256="f" * 64)
SEEN = ("An empty street.", "A deer beside the street.", "A deer on the street.")
PATH = ("Out of distribution", "Interactional", "Animals", "Deer on the road")
EXAMPLES = GiveExamples(shown=("A deer crosses.", "Thick fog."), count=2)
CLASSES = ClassifyExamples(asked=EXAMPLES, given=("A sofa lies on the road.", "A car reverses."))

SAMPLES = (
    EXAMPLES,
    CLASSES,
    ProposeTree(asked=CLASSES, classes=("environmental", "interactional"), nodes=5),
    ImagineScenario(
        shown=("A deer crosses.",),
        catalogue=DIGEST,
        covered=("Fog", "Deer on the road"),
        unlisted=7,
        thin=("Animals",),
        refused=("A stag leaps onto the road.",),
        least_km=1e4,
        most_km=1e6,
        corner="Animals",
    ),
    PlaceScenario(
        text="A stag leaps onto the road.",
        nodes=NODES,
        hidden=(Hidden(id="animals", leaves=2),),
        full=("deer",),
        procedure="closed",
    ),
    JudgeBranch(path=PATH, catalogue=DIGEST, exact=True),
    JudgeBranches(paths=(PATH, (*PATH[:-1], "Fog")), catalogue=DIGEST, exact=True),
    DesignMotion(name="fall_over", path=PATH, categories=("vegetation", "object")),
    DesignProp(
        name="low_wall",
        category="work_zone",
        path=PATH,
        known=(
            KnownPart(id="cone", length_m=0.4, width_m=0.4, height_m=0.7),
            KnownPart(id="crate", length_m=1.0, width_m=1.0, height_m=1.0),
        ),
    ),
    RecogniseProp(pictures=FRAMES, labels=("a red locomotive", "none of these")),
    DescribePath(
        path=PATH,
        count=3,
        avoid=("A deer stands on the highway.",),
        catalogue=DIGEST,
        made=("train: a red locomotive",),
    ),
    DescribeOrdinary(text="A stag leaps onto the road.", path=PATH),
    EstimateRarity(texts=("A stag leaps onto the road.", "Rain."), population="cars"),
    ExtractClaims(text="A stag leaps onto the road at night."),
    StageScene(
        text="A stag leaps onto the road.",
        path=PATH,
        claims=(Claim(kind="thing", value="present", subject="stag", quote="A stag"),),
        roads=("avenue",),
        catalogue=DIGEST,
    ),
    MarkHazard(
        title="AEB at night",
        actors=(
            ActorLine(
                id="vut", what="a car", does="follow_lane: drives", ahead_m=40.5, left_m=0.25
            ),
            ActorLine(id="stag", what="a deer", does="bolt: runs", ahead_m=60.5, left_m=-4.25),
        ),
    ),
    DescribeFrame(frames=FRAMES, descriptions=SEEN[:2], total=5),
    NameAspect(frames=FRAMES, descriptions=SEEN, facts=FACTS, rear=REAR),
    NameOodAspect(frames=FRAMES, descriptions=SEEN, facts=FACTS, rear=REAR),
    ChooseAspect(
        frames=FRAMES,
        descriptions=SEEN,
        facts=FACTS,
        rear=REAR,
        labels=("Deer on the road", "Nothing is out of the ordinary"),
    ),
    JudgeAspect(
        aspect="a stag",
        path=PATH[1:],
        visible=(Visible(what="stag", where="in the ego's lane", doing="standing"),),
    ),
    ChooseAction(
        frames=FRAMES,
        descriptions=SEEN,
        facts=FACTS,
        rear=REAR,
        options=(
            ActionOption(id="stop", description="brake to a stop"),
            ActionOption(id="keep_speed", description="drive on"),
        ),
        is_collision_only=True,
    ),
)
