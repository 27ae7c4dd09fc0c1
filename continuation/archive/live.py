"""Files that grow under their final name: made beside it; readable, locked and safe from a kill once they have it."""

from __future__ import annotations

from pathlib import Path as File
from typing import Any

from continuation.archive.atomic import beside, check_new, like, publish
from continuation.archive.store import Store


def create(target: File, *arguments: Any, **options: Any) -> Store:
    """A new file, live from the moment on at which it has its name; arguments as for `Store`.

    Raises `ArchiveError` if the file exists or cannot be made.
    """
    check_new(target)
    with beside(target) as part:
        return publish_live(Store(part, *arguments, **options), target)


def publish_live(store: Store, target: File, *, replace: bool = False) -> Store:
    """Let a file written beside go live, and give it its name, as `publish` does."""
    part = store.file
    try:
        store.go_live()
        if replace:
            like(part, target)
        publish(part, target, replace=replace)
    except BaseException:
        store.close()
        raise
    store.file = target
    return store
