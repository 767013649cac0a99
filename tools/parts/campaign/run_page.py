"""The law that the page of a run opens in a browser without a complaint."""

import pathlib
import shutil
import subprocess

from .calls import Broken

SECONDS = 400  # in which a page opens, even on a busy machine without a GPU


class Page:
    """A browser, which shows pages of the viewer in the folder of a build."""

    def __init__(self, built):
        self._viewer = built / "share" / "evodevo" / "viewer"
        self.obstacle = self._obstacle()

    def _obstacle(self):
        """Returns why no page can be opened, or an empty text."""
        if not shutil.which("node"):
            return "there is no Node.js"
        if not (self._viewer / "page.html").exists():
            return "the viewer has not been built"
        return "" if self._script("chromium").returncode == 0 else "there is no Chromium"

    def opens(self, file):
        """Raises Broken if the browser complains of a page."""
        try:
            opened = self._script(file)
        except subprocess.TimeoutExpired:
            raise Broken(f"page: not open after {SECONDS} s") from None
        if opened.returncode != 0:
            raise Broken(f"page: {' / '.join(opened.stdout.splitlines()[:3])[:500]}")

    def _script(self, argument):
        script = pathlib.Path(__file__).parent / "open_page.mjs"
        return subprocess.run(
            ["node", script, self._viewer, argument],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=SECONDS,
        )
