"""Archives: the files of a sweep in one ZIP file, with a list of their checksums."""

from __future__ import annotations

import hashlib
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile, ZipInfo

from crackfront.data.files import replace_atomically

MANIFEST = "SHA256SUMS"
"""List of checksums in an archive, as `sha256sum --check` reads it."""

_COMPRESSED = {".nc", ".png", ".pdf", ".gif", ".zip"}
"""Files that become no smaller."""


def write_archive(folder: Path, path: Path, *, curves: bool) -> int:
    """Write the files of a sweep and their checksums into a ZIP file.

    Checkpoints and what is only half written are left out. Names in the archive begin with that of
    the folder, and the list stands in it too: unpack, go there, `sha256sum --check SHA256SUMS`.

    Parameters
    ----------
    folder : Path
        Folder of the sweep.
    path : Path
        The archive.
    curves : bool
        Whether the files of the single simulations belong to it.

    Returns
    -------
    int
        Number of files.

    Raises
    ------
    ValueError
        If the folder holds no file of a sweep.
    """
    if not (folder / "hysteresis.nc").is_file():
        raise ValueError(f"{folder} holds no hysteresis.nc; run the sweep before it is archived")
    left_out = {"checkpoints"} if curves else {"checkpoints", "curves"}
    files = [
        file
        for file in sorted(folder.rglob("[!.]*"))
        if file.is_file()
        and not file.is_symlink()
        and file.relative_to(folder).parts[0] not in left_out
        and file.resolve() != path.resolve()
    ]

    def write(part: Path) -> None:
        sums = []
        with ZipFile(part, "w") as archive:
            for file in files:
                name = file.relative_to(folder)
                sums.append(f"{_added(archive, file, str(folder.name / name))}  {name}\n")
            archive.writestr(f"{folder.name}/{MANIFEST}", "".join(sums))

    replace_atomically(path, write)
    return len(files)


def _added(archive: ZipFile, file: Path, name: str) -> str:
    """Checksum of a file that is added to an archive, of just what is added."""
    # A clock may have been wrong: ZIP knows no year before 1980.
    entry = ZipInfo.from_file(file, name, strict_timestamps=False)
    entry.compress_type = ZIP_STORED if file.suffix in _COMPRESSED else ZIP_DEFLATED
    digest = hashlib.sha256()
    with file.open("rb") as source, archive.open(entry, "w") as target:
        while content := source.read(2**20):
            digest.update(content)
            target.write(content)
    return digest.hexdigest()
