"""SUMO's network of a map: netconvert makes it from the OpenDRIVE file."""

import contextlib
import io
import shutil
import subprocess
import weakref
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

from oodscen._words.text import one_line
from oodscen.driving._roads.building import read_map
from oodscen.errors import MissingExtra, SimulatorError

UNKNOWN_LANES = ("slipLane", "connectingRamp", "bus", "taxi", "HOV")
"""Types of driving lanes that netconvert would leave out."""
_OPTIONS = ("--offset.disable-normalization", "true", "--no-turnarounds", "true")
"""netconvert's options: coordinates stay as in the file, and no driver turns back where a road ends."""
_TYPES = "<types>{}</types>"
_TYPE = '<type id="{}" priority="1" speed="13.89"/>'
"""A kind of lane in netconvert's terms; the speed does not bind the drivers."""
_LONGEST_REASON = 500
_TIMEOUT_S = 600.0
"""Time after which netconvert is ended, s."""


def load_sumo() -> tuple[Any, str]:
    """Return the module `libsumo`, and the folder of SUMO's programs.

    Raises:
        MissingExtra: If one of them is not installed.
        SimulatorError: If one of them cannot be loaded.
    """
    try:
        with contextlib.redirect_stdout(io.StringIO()):  # It prints about versions of pyarrow.
            import libsumo
            import sumo
    except ModuleNotFoundError as error:
        raise MissingExtra("the SUMO simulator", "sumo", str(error.name)) from None
    except ImportError as error:
        raise SimulatorError(f"sumo: libsumo cannot be loaded: {one_line(str(error))}") from None
    return libsumo, f"{sumo.SUMO_HOME}/bin"


class Networks:
    """Networks of the maps seen so far, in a folder of their own."""

    def __init__(self, programs: str) -> None:
        self._netconvert = f"{programs}/netconvert"
        self._folder = mkdtemp(prefix="oodscen-sumo-")
        self.close = weakref.finalize(self, shutil.rmtree, self._folder, ignore_errors=True)
        """Deletes the folder."""
        types = Path(self._folder) / "lanes.typ.xml"
        types.write_text(_TYPES.format("".join(map(_TYPE.format, UNKNOWN_LANES))))
        self._types = f"{programs}/../data/typemap/opendriveNetconvert.typ.xml,{types}"
        """Files of the kinds of lanes that netconvert makes: its own, and those that it would leave out."""
        self._files: dict[bytes, Path] = {}
        """The networks by the content of their maps."""

    def path(self, file: str) -> Path:
        """Return the network of an OpenDRIVE file, named as in `RoadMap.file`.

        Raises:
            DataError: If the file cannot be read.
            SimulatorError: If netconvert cannot be started, fails, or takes too long.
        """
        content = read_map(file)
        if content not in self._files:
            network = Path(self._folder) / f"{len(self._files)}.net.xml"
            self._convert(file, content, network)
            self._files[content] = network
        return self._files[content]

    def _convert(self, file: str, content: bytes, network: Path) -> None:
        source = network.with_suffix(".xodr")
        source.write_bytes(content)
        files = ["--opendrive-files", str(source), "-o", str(network)]
        command = [self._netconvert, *files, "--type-files", self._types, *_OPTIONS]
        try:
            process = subprocess.run(command, capture_output=True, check=False, timeout=_TIMEOUT_S)
        except OSError as error:
            raise SimulatorError(f"sumo: netconvert cannot be started: {error}") from None
        except subprocess.TimeoutExpired:
            message = f"sumo: netconvert has not ended after {_TIMEOUT_S:g} s with {file}"
            raise SimulatorError(message) from None
        if process.returncode or not network.is_file():
            reason = one_line(process.stderr.decode("utf-8", "replace"))
            raise SimulatorError(f"sumo: netconvert refuses {file}: {reason[-_LONGEST_REASON:]}")
