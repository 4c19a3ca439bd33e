"""gnl, the graph neural localizer: from a first-person view to a place, and on to the next view."""

import os

# One BLAS thread a process: two on two busy cores make a net many times slower. NumPy reads this when it is imported;
# where that was before, it holds for the processes beside this one alone.
os.environ |= {name: "1" for name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS")
               if name not in os.environ}
