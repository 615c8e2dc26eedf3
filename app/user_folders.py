"""Where this user's programs keep settings, unsaved work (data) and what can be made again (cache).

The state is what networks have written; it is never inside a network's folder.
"""

import platformdirs

FOLDERS = platformdirs.PlatformDirs("imagechain", appauthor=False)
