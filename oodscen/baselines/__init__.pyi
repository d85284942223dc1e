from ._baseline import load_baseline as load_baseline
from ._controls import load_controls as load_controls
from ._off_topic import load_off_topic as load_off_topic
