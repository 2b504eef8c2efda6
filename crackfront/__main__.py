"""`python -m crackfront` is the command `crackfront`."""

from crackfront.cli import main

if __name__ == "__main__":
    main()
