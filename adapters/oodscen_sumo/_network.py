"""SUMO's network of a map: netconvert makes it from the OpenDRIVE file."""

import contextlib
import io
import shutil
import subprocess
import weakref
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

from oodscen.driving._roads.building import read_map
from oodscen.errors import MissingExtra, SimulatorError

OPTIONS = ("--offset.disable-normalization", "true")
"""Places keep the file's coordinates."""


def load_sumo() -> tuple[Any, str]:
    """Return the module `libsumo`, and the folder of SUMO's programs.

    Raises:
        MissingExtra: If one of them is not installed.
    """
    try:
        with contextlib.redirect_stdout(io.StringIO()):  # It prints about versions of pyarrow.
            import libsumo
            import sumo
    except ModuleNotFoundError as error:
        raise MissingExtra("the SUMO simulator", "sumo", f"{error.name}") from None
    return libsumo, f"{sumo.SUMO_HOME}/bin"


class Networks:
    """Networks of the maps seen so far, in a folder of their own."""

    def __init__(self, programs: str) -> None:
        self._netconvert = f"{programs}/netconvert"
        self._folder = mkdtemp(prefix="oodscen-sumo-")
        self.close = weakref.finalize(self, shutil.rmtree, self._folder, ignore_errors=True)
        """Deletes the folder."""
        self._files: dict[str, Path] = {}

    def path(self, file: str) -> Path:
        """Return the network of an OpenDRIVE file, named as in `RoadMap.file`.

        Raises:
            SimulatorError: If netconvert fails.
        """
        if file not in self._files:
            made = Path(self._folder) / f"{len(self._files)}.net.xml"
            made.with_suffix(".xodr").write_bytes(read_map(file))
            options = ["--opendrive-files", made.with_suffix(".xodr"), "-o", made, *OPTIONS]
            command = list(map(str, [self._netconvert, *options]))
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            if done.returncode or not made.is_file():
                raise SimulatorError(f"sumo: netconvert refuses {file}: {done.stderr[-500:]}")
            self._files[file] = made
        return self._files[file]
