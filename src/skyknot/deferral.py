"""Fields of a value that are computed when one of them is first read."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Self


class Deferring:
    """A frozen dataclass some of whose fields may come later; its constructor takes all of them.

    It is the same value either way: in ``repr``, ``replace``, ``asdict``, copies and pickles. A
    field that may come later has no default but a factory's, for a default is an attribute of the
    class, and would be found there.
    """

    @classmethod
    def deferred(cls, rest: Callable[[], Mapping[str, Any]], **known: Any) -> Self:
        """Return a value of which ``rest`` tells the fields that are not known yet.

        Parameters
        ----------
        rest : returns fields by name, the same however often it is called: it may be, once by each
            thread that asks while another does. It is let go of afterwards
        known : all other fields, by name
        """
        made = object.__new__(cls)
        made.__dict__.update(known, _rest=rest)
        return made

    if not TYPE_CHECKING:  # a type checker would take every name for an attribute

        def __getattr__(self, name: str) -> Any:
            """Compute the fields that are missing; called for names that are not there."""
            if name in type(self).__dataclass_fields__:
                self._complete()
                if name in self.__dict__:
                    return self.__dict__[name]
            raise AttributeError(f"'{type(self).__name__}' object has no attribute '{name}'")

    def __getstate__(self) -> dict[str, Any]:
        """Return all fields, for copies and pickles."""
        self._complete()
        return self.__dict__.copy()

    def _complete(self) -> None:
        rest = self.__dict__.get("_rest")
        if rest is not None:
            for name, value in rest().items():
                self.__dict__.setdefault(name, value)
            self.__dict__.pop("_rest", None)
