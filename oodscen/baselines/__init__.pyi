from ._baseline import load_baseline as load_baseline
from ._controls import load_controls as load_controls
