"""What the documents promise.

  documents.py links ROOT             every relative link leads to a file and a heading
  documents.py words ROOT E2LF        every command names a verb, options and files that exist
  documents.py script PAGE [NOT_RUN]  the commands of the page as a script for bash; see not_run.txt
  documents.py block PAGE WORD        the first block of the page that contains a word
"""
import pathlib
import re
import subprocess
import sys

BLOCK = r"^ *```(\w*)\n(.*?)^ *```"
FOLDERS = "bench|cameras|configs|docs|examples|models|python|scripts|src|testing"


def pages(root):
    return [*root.glob("*.md"), *root.glob("docs/**/*.md"), *root.glob("models/*.md")]


def without_blocks(text):
    return re.sub(BLOCK, "", text, flags=re.S | re.M)


def anchors(path):
    headings = re.findall(r"^#+ +(.+)$", without_blocks(path.read_text()), flags=re.M)
    return {re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-") for heading in headings}


def broken_links(root):
    for page in pages(root):
        for target in re.findall(r"\]\(([^)\s]+)\)", without_blocks(page.read_text())):
            if re.match(r"[a-z]+:", target):
                continue
            path, _, anchor = target.partition("#")
            place = (page.parent / path) if path else page
            if not place.exists():
                yield f"{page}: {target} does not exist"
            elif anchor and anchor not in anchors(place):
                yield f"{page}: {target} is no heading"


def shell_lines(page, languages=("sh",)):
    """The lines of the page's shell blocks, without their indentation; continued lines are joined."""
    for language, block in re.findall(BLOCK, page.read_text(), flags=re.S | re.M):
        if language in languages:
            indent = min((len(line) - len(line.lstrip()) for line in block.splitlines() if line.strip()), default=0)
            text = "\n".join(line[indent:] for line in block.splitlines())
            yield from re.sub(r"\\\n *", "", text).splitlines()


def script(page, not_run):
    """Commands as written. One that a line of `not_run` (a regular expression, then why) fits is named in its place."""
    rules = [line.split("  # ") for line in not_run if "  # " in line]
    for line in shell_lines(page):
        reason = next((why.strip() for pattern, why in rules if re.search(pattern.strip(), line)), None)
        yield f"cat <<'NOT_RUN'\nnot run ({reason}): {line}\nNOT_RUN" if reason else line


class Help:
    """What e2lf says of its verbs."""

    def __init__(self, e2lf):
        self.e2lf, self.texts = e2lf, {}
        self.verbs = self.listed()

    def of(self, *words):
        if words not in self.texts:
            run = subprocess.run([self.e2lf, *words, "--help-all"], capture_output=True, text=True, check=False)
            self.texts[words] = run.stdout if run.returncode == 0 else ""
        return self.texts[words]

    def listed(self, *words):
        """The verbs in the list that e2lf prints, or the verbs below a verb."""
        text = self.of(*words)
        return re.findall(r"^  ([a-z-]+) ", text, flags=re.M) if "<verb> [flags]" in text else []

    def options(self, *words):
        return set(re.findall(r"--[a-z][a-z0-9-]*", self.of(*words)))

    def all_options(self):
        found = self.options()
        for verb in self.verbs:
            found |= self.options(verb)
            for sub in self.listed(verb):
                found |= self.options(verb, sub)
        return found


def spans(page):
    """What stands in backquotes in the text of a page."""
    return re.findall(r"`([^`\n]+)`", without_blocks(page.read_text()))


def wrong_words(command, programs, everywhere):
    """What e2lf does not know in a command or a part of one."""
    command = command.split("  #")[0]
    if command.startswith("--"):
        option = re.match(r"--[a-z0-9-]*", command).group()
        if option not in everywhere:
            yield f"{option} is no option of e2lf"
    for piece in re.split(r"&&|\|\||[|;()]|<\(", command):
        words = re.sub(r"^(\s*(time|[A-Z0-9_]+=\S*))+\s", " ", piece).split()
        if words[:2] == ["./run", "e2lf"]:
            words = words[1:]
        elif words[:2] == ["./run", "bench"]:
            words = ["e2lf-bench", *words[2:]]
        elif words[:1] == ["./run"] and words[1:2] in (["train"], ["resume"], ["view"]):
            words = ["e2lf", *words[1:]]
        help_of = programs.get(words[0]) if words else None
        if help_of is None or len(words) < 2 or not re.fullmatch(r"[a-z-]+", words[1]):
            continue
        if words[1].startswith("--"):
            continue
        if words[1] not in help_of.verbs:
            yield f"{words[1]} is no verb"
            continue
        verb = words[1:3] if words[2:3] and words[2] in help_of.listed(words[1]) else words[1:2]
        known = help_of.options(*verb) | help_of.options(verb[0])
        for word in words:
            option = re.match(r"--[a-z][a-z0-9-]*", word)
            if option and option.group() not in known:
                yield f"{option.group()} is no option of {' '.join(verb)}"


def wrong_commands(root, e2lf):
    programs = {"e2lf": Help(e2lf), "e2lf-bench": Help(f"{e2lf}-bench")}
    everywhere = set().union(*(help_of.all_options() for help_of in programs.values()))
    for page in pages(root):
        if page.name == "CHANGELOG.md":
            continue
        for command in [*shell_lines(page, ("sh", "")), *spans(page)]:
            for problem in wrong_words(command, programs, everywhere):
                yield f"{page}: {problem}: {command}"
            for path in re.findall(rf"(?<![\w./-])(?:{FOLDERS})/[\w./-]+(?![\w./<*-])", command):
                if not (root / path.rstrip(".")).exists() and not (page.parent / path).exists():
                    yield f"{page}: {path} does not exist: {command}"


# Which files run the blocks of a language; they name the page.
RUNNERS = {"cmake": "testing/suite/cases/*.sh", "js": "testing/suite/cases/*.sh", "json": "testing/suite/cases/*.sh", "python": "python/test/*.py"}


def text_of(root, pattern):
    return "".join(path.read_text() for path in sorted(root.glob(pattern)))


def commands_outside(root):
    """Blocks that no case runs: commands that are not marked as sh, and blocks of pages that no case names."""
    cases = text_of(root, "testing/suite/cases/documents*.sh")
    for page in [root / "README.md", *root.glob("docs/**/*.md")]:
        name = str(page.relative_to(root))
        if any(True for _ in shell_lines(page)) and name not in cases:
            yield f"{name}: no case runs its commands"
        for language in {language for language, _ in re.findall(BLOCK, page.read_text(), flags=re.S | re.M)} - {"", "sh"}:
            if language not in RUNNERS or f"{page.stem}.md" not in text_of(root, RUNNERS[language]):
                yield f"{name}: no test runs its blocks in {language}"
        for line in shell_lines(page, ("",)):
            if re.match(r"(time )?(\./run|e2lf|e2lf-bench|e2lf-train) ", line):
                yield f"{name}: a command in a block that is not marked as sh: {line}"


def main(kind, *arguments):
    if kind == "script":
        not_run = pathlib.Path(arguments[1]).read_text().splitlines() if len(arguments) > 1 else []
        print("\n".join(script(pathlib.Path(arguments[0]), not_run)))
        return 0
    if kind == "block":
        print(next(block for _, block in re.findall(BLOCK, pathlib.Path(arguments[0]).read_text(), flags=re.S | re.M) if arguments[1] in block))
        return 0
    root = pathlib.Path(arguments[0]).resolve()
    if kind == "links":
        problems = [*broken_links(root), *commands_outside(root)]
    else:
        problems = list(wrong_commands(root, arguments[1]))
    print("\n".join(problems))
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
