"""Files that are written whole or not at all."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable
from pathlib import Path

from skyknot.errors import UserError


def replace_file(path: Path, write: Callable[[Path], object]) -> None:
    """Call ``write`` on a temporary file beside ``path``, then rename it; clean up on failure.

    Raises
    ------
    UserError
        When the file cannot be written; what was there before is untouched.
    """
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write(part)
        os.replace(part, path)
    except OSError as error:
        raise UserError(
            "The file cannot be written.",
            where=str(path),
            found=f"{type(error).__name__}: {error.strerror}",
            expected="a writable folder with enough space",
            do="Choose another place, or free some space; an earlier file there is untouched.",
        ) from error
    finally:
        with contextlib.suppress(OSError):
            part.unlink()
