"""Says that it is ready, then never ends by itself."""

import time

print("ready", flush=True)
time.sleep(600)
