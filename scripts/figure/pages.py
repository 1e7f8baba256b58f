"""The files that are made anew: as they are, and as they should be."""

import difflib


class Pages:
    """Files by their path in the repository."""

    def __init__(self, root):
        self.root, self.now, self.faults = root, {}, []

    def old(self, path):
        file = self.root / path
        return file.read_text(encoding="utf-8") if file.exists() else ""

    def text(self, path):
        return self.now[path] if path in self.now else self.old(path)

    def put(self, path, text):
        self.now[path] = text

    def changed(self):
        return [path for path, text in sorted(self.now.items()) if text != self.old(path)]

    def differences(self):
        """A unified diff of each file that is not as it should be."""
        return "".join(difference(path, self.old(path), self.now[path]) for path in self.changed())

    def write(self):
        for path in self.changed():
            file = self.root / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(self.now[path], encoding="utf-8")


def difference(path, old, new):
    lines = difflib.unified_diff(old.splitlines(True), new.splitlines(True), path, f"{path}, as it should be")
    return "".join(line if line.endswith("\n") else line + "\n" for line in lines)
