"""The defects of verification/mutations.py still fit the sources."""

from __future__ import annotations

import mutations
import pytest


@pytest.mark.parametrize("mutation", mutations.MUTATIONS, ids=lambda mutation: mutation.name)
def test_replaces_text_that_is_there_once(mutation: mutations.Mutation) -> None:
    """Each old text is in its file exactly once, and changes."""
    for file in mutation.files:
        text = (mutations.ROOT / file).read_text()
        for old, new in mutation.edits:
            assert text.count(old) == 1, f"{file}: {old}"
            assert old != new


def test_names_are_unique() -> None:
    """A name chooses one mutation."""
    names = [mutation.name for mutation in mutations.MUTATIONS]
    assert len(set(names)) == len(names)
