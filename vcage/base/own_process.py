"""True where this process runs a command of ours and nothing else, so that it can be forked.

No threads of others would be missing in its fork, as long as nothing is drawn.
"""

runs_a_command = False
