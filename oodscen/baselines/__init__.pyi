from ._controls import load_controls as load_controls
from ._loading import load_baseline as load_baseline
