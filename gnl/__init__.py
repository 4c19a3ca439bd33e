"""gnl, the graph neural localizer: from a first-person view to a place, and on to the next view."""

import os

# One BLAS thread per process: two on two busy cores make a net many times slower. NumPy reads this when it is imported;
# if that was earlier, only the processes that this one starts heed it.
os.environ |= {name: "1" for name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS")
               if name not in os.environ}
