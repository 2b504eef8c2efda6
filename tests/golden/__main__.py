"""Renew the golden files: `python -m tests.golden`, after a version was raised."""

import argparse
import sys

from tests.golden.files import renewed_files
from tests.golden.golden import NotRaisedError, write_golden


def main() -> str | None:
    """Write both files, or say why not."""
    argparse.ArgumentParser("python -m tests.golden", description=__doc__).parse_args()
    try:
        files = renewed_files()
    except NotRaisedError as error:
        return f"No file is renewed: {error}"
    for path, golden in files.items():
        write_golden(path, golden)
        sys.stdout.write(f"{path.name}: version {golden.version}, {len(golden.scenes)} scenes\n")
    return None


if __name__ == "__main__":
    sys.exit(main())
