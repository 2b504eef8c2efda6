"""`crackfront completion`: what a shell needs to complete commands and options."""

from __future__ import annotations

from typing import Any

import click
from click.shell_completion import get_completion_class

from crackfront.cli.report import examples

_SHELLS = ("bash", "zsh", "fish")


@click.command(
    epilog=examples(
        'eval "$(crackfront completion bash)"          # in ~/.bashrc',
        'eval "$(crackfront completion zsh)"           # in ~/.zshrc',
        "crackfront completion fish > ~/.config/fish/completions/crackfront.fish",
    )
)
@click.argument("shell", type=click.Choice(_SHELLS))
@click.pass_context
def completion(context: click.Context, shell: str) -> None:
    """Print the script by which a shell completes commands and options."""
    kind = get_completion_class(shell)
    assert kind is not None, "click knows these shells"
    arguments: dict[str, Any] = {}
    root = context.find_root()
    script = kind(root.command, arguments, "crackfront", "_CRACKFRONT_COMPLETE")
    click.echo(script.source())
