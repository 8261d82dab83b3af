"""User errors: what is wrong, where, what was found, what was expected, what to do."""

from __future__ import annotations


class UserError(Exception):
    """A mistake in the user's input, told in five parts before any work is done.

    Parameters
    ----------
    what : str
        What is wrong, in one sentence.
    where : str
        The field, file line, state or constraint concerned, by its name.
    found : str
        What was found there.
    expected : str
        What is allowed there.
    do : str
        The next thing to do.
    """

    def __init__(self, what: str, *, where: str, found: object, expected: str, do: str) -> None:
        self.what = what
        self.where = where
        self.found = str(found)
        self.expected = expected
        self.do = do
        super().__init__(str(self))

    def __str__(self) -> str:
        """Return the five parts, one to a line."""
        return (
            f"{self.what}\n"
            f"  where:    {self.where}\n"
            f"  found:    {self.found}\n"
            f"  expected: {self.expected}\n"
            f"  do:       {self.do}"
        )

    def parts(self) -> dict[str, str]:
        """Return the five parts by name, for JSON output."""
        return {
            "what": self.what,
            "where": self.where,
            "found": self.found,
            "expected": self.expected,
            "do": self.do,
        }
