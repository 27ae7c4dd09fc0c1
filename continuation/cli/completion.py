"""``continuation completion SHELL``: a script that lets a shell complete commands, options and names of homotopies."""

from __future__ import annotations

import argparse

from continuation.arguments import plugins
from continuation.cli.parser import SUCCESS, Subparsers

_BASH = """\
_continuation() {{
    local word="${{COMP_WORDS[COMP_CWORD]}}" words=""
    if [ "$COMP_CWORD" -eq 1 ]; then
        words="{commands}"
    else
        case "${{COMP_WORDS[1]}}" in
{cases}
        esac
    fi
    COMPREPLY=($(compgen -W "$words" -- "$word"))
}}
complete -o default -F _continuation continuation
"""

NAMED = {
    "trace": (plugins.GROUP,), "check": (plugins.GROUP,), "plugins": (plugins.GROUP, plugins.SCENES),
    "solve": (plugins.SCENES,),
}  # fmt: skip
"""Commands whose argument is a homotopy, or a scene, by the groups of these."""


def register(subparsers: Subparsers) -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "completion",
        help="a script for the completion of commands by the shell",
        description='In ~/.bashrc: eval "$(continuation completion bash)"; the same with zsh in ~/.zshrc; for fish: '
        "continuation completion fish > ~/.config/fish/completions/continuation.fish",
    )
    parser.add_argument("shell", metavar="SHELL", choices=("bash", "zsh", "fish"), help="bash, zsh or fish")
    parser.set_defaults(run=lambda arguments: _run(arguments, subparsers))


def _run(arguments: argparse.Namespace, subparsers: Subparsers) -> int:
    parsers: dict[str, argparse.ArgumentParser] = getattr(subparsers, "choices", {})
    words = {name: _words(name, parser) for name, parser in parsers.items()}
    if arguments.shell == "fish":
        print("complete -c continuation -f -n __fish_use_subcommand -a '" + " ".join(words) + "'")
        for name, own in words.items():
            print(f"complete -c continuation -n '__fish_seen_subcommand_from {name}' -a '{' '.join(own)}'")
        return SUCCESS
    cases = "\n".join(f'            {name}) words="{" ".join(own)}" ;;' for name, own in words.items())
    script = _BASH.format(commands=" ".join(words), cases=cases)
    print(("autoload -U +X bashcompinit && bashcompinit\n" if arguments.shell == "zsh" else "") + script, end="")
    return SUCCESS


def _words(name: str, parser: argparse.ArgumentParser) -> list[str]:
    options = [option for action in parser._actions for option in action.option_strings if option.startswith("--")]
    return [*options, *(known for group in NAMED.get(name, ()) for known in plugins.available(group))]
