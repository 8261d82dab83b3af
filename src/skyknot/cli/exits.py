"""How commands end: exit statuses, five-part messages, the verdict on the last line."""

from __future__ import annotations

import functools
import json
import sys
from collections.abc import Callable
from enum import IntEnum
from typing import Any, ParamSpec

import typer

from skyknot.errors import UserError

P = ParamSpec("P")


class Exit(IntEnum):
    """Exit statuses."""

    GOOD = 0
    USER_ERROR = 2
    NOT_SOLVED = 3
    NOT_CERTIFIED = 4
    INTERRUPTED = 130


def command(function: Callable[P, Exit]) -> Callable[P, None]:
    """Return a command that ends with the function's exit status and never with a traceback.

    A UserError is told on standard error, and as JSON on standard output where ``--json`` asks.
    """

    @functools.wraps(function)
    def run(*arguments: P.args, **options: P.kwargs) -> None:
        try:
            status = function(*arguments, **options)
        except UserError as error:
            tell(error)
            if options.get("as_json"):
                print_json({"error": error.parts(), "exit_status": int(Exit.USER_ERROR)})
            status = Exit.USER_ERROR
        except KeyboardInterrupt:
            typer.echo("Interrupted: nothing was written.", err=True)
            status = Exit.INTERRUPTED
        raise typer.Exit(int(status))

    return run


def tell(error: UserError) -> None:
    """Print the five parts of a user error on standard error, then the verdict."""
    typer.echo(f"error: {error}", err=True)
    typer.echo("Not started: a mistake in the input, told above.", err=True)


def print_json(content: dict[str, Any]) -> None:
    """Print one JSON object on standard output; numbers that are not finite become null."""
    sys.stdout.write(json.dumps(finite(content), ensure_ascii=False, allow_nan=False) + "\n")


def finite(value: Any) -> Any:
    """Return plain data with NaN and infinity replaced by None."""
    if isinstance(value, dict):
        return {str(key): finite(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [finite(entry) for entry in value]
    if isinstance(value, float) and not (-float("inf") < value < float("inf")):
        return None
    return value
