#!/usr/bin/env python3
"""Writes the completions of a shell: completions.py GSCL bash|zsh|fish >FILE

All words come from the option tables of the program: gscl --help=commands and gscl COMMAND --help=options.
"""
import dataclasses
import subprocess
import sys

FOLDERS, FILES = {"DIR"}, {"FILE", "IMAGE"}  # names of values


@dataclasses.dataclass
class Option:
    name: str
    letter: str
    argument: str  # empty for flags
    words: list
    about: str


def lines(*command):
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    return [line.split("\t") for line in done.stdout.splitlines()]


def options_of(gscl, command):
    table = lines(gscl, command, "--help=options")
    found = [Option(name, letter, argument, words.split(", ") if words else [], about)
             for name, letter, argument, words, about in table]
    return found + [Option("help", "h", "", [], "print this text")]


# ---- bash -----------------------------------------------------------------------------------------

BASH = """# Completions of gscl for bash.
_gscl() {{
    local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD - 1]}} options=
    COMPREPLY=()
    if [ "$COMP_CWORD" = 1 ]; then
        COMPREPLY=($(compgen -W "{commands} help" -- "$current"))
        return
    fi
    case ${{COMP_WORDS[1]}}:$previous in
{values}
    esac
    case ${{COMP_WORDS[1]}} in
    help) COMPREPLY=($(compgen -W "{commands}" -- "$current")); return ;;
{options}
    esac
    case $current in
    -*) COMPREPLY=($(compgen -W "$options" -- "$current")) ;;
    *) COMPREPLY=($(compgen -f -- "$current")) ;;
    esac
}}
complete -o filenames -F _gscl gscl"""


def bash_value(command, option):
    names = "|".join(f"{command}:{name}" for name in
                     [f"--{option.name}"] + ([f"-{option.letter}"] if option.letter else []))
    kind = "-f" if option.argument in FILES else "-d" if option.argument in FOLDERS else f"-W \"{' '.join(option.words)}\""
    return f"    {names}) COMPREPLY=($(compgen {kind} -- \"$current\")); return ;;"


def bash(tables):
    values = [bash_value(command, option) for command, (_, options) in tables.items() for option in options
              if option.argument]
    words = [f"    {command}) options=\"{' '.join('--' + option.name for option in options)}\" ;;"
             for command, (_, options) in tables.items()]
    return BASH.format(commands=" ".join(tables), values="\n".join(values), options="\n".join(words))


# ---- zsh ------------------------------------------------------------------------------------------

ZSH = """#compdef gscl
# Completions of gscl for zsh.
_gscl() {{
    local -a commands
    commands=(
{commands}
    )
    if (( CURRENT == 2 )); then
        _describe command commands
        return
    fi
    local chosen=$words[2]
    shift words
    (( CURRENT-- ))
    case $chosen in
{cases}
    esac
}}
_gscl "$@\""""


def zsh_quoted(text):
    return "'" + text.replace("'", "'\\''") + "'"


def zsh_option(option):
    about = option.about.replace("\\", "\\\\").replace("[", "\\[").replace("]", "\\]").replace(":", "\\:")
    action = "_files" if option.argument in FILES else "_files -/" if option.argument in FOLDERS else ""
    action = action or ("(" + " ".join(option.words) + ")" if option.words else " ")
    value = f":{option.argument}:{action}" if option.argument else ""
    both = f"(-{option.letter} --{option.name})" if option.letter else ""
    names = ([f"-{option.letter}"] if option.letter else []) + [f"--{option.name}"]
    return [zsh_quoted(f"{both}{name}[{about}]{value}") for name in names]


def zsh(tables):
    about = [zsh_quoted(command + ":" + text.replace(":", "\\:")) for command, (text, _) in tables.items()]
    cases = []
    for command, (_, options) in tables.items():
        words = [word for option in options for word in zsh_option(option)] + ["'*:file:_files'"]
        cases.append(f"    {command}) _arguments \\\n        " + " \\\n        ".join(words) + " ;;")
    return ZSH.format(commands="\n".join("        " + text for text in about), cases="\n".join(cases))


# ---- fish -----------------------------------------------------------------------------------------


def fish_quoted(text):
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"


def fish_option(command, option):
    words = [f"complete -c gscl -n '__fish_seen_subcommand_from {command}' -l {option.name}"]
    if option.letter:
        words.append(f"-s {option.letter}")
    if option.argument in FOLDERS:
        words.append("-x -a '(__fish_complete_directories)'")
    elif option.argument in FILES:
        words.append("-r -F")
    elif option.argument:
        words.append(f"-x -a {fish_quoted(' '.join(option.words))}" if option.words else "-x")
    return " ".join(words + [f"-d {fish_quoted(option.about)}"])


def fish(tables):
    text = ["# Completions of gscl for fish."]
    for command, (about, options) in tables.items():
        text.append(f"complete -c gscl -f -n __fish_use_subcommand -a {command} -d {fish_quoted(about)}")
        text += [fish_option(command, option) for option in options]
    return "\n".join(text)


def main():
    gscl, shell = sys.argv[1:]
    tables = {name: (about, options_of(gscl, name)) for name, about in lines(gscl, "--help=commands")}
    print({"bash": bash, "zsh": zsh, "fish": fish}[shell](tables))


if __name__ == "__main__":
    main()
