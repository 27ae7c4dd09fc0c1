import os, sys
from concurrent.futures import ThreadPoolExecutor
import numpy as np
from attrs import frozen
from continuation import Budget, Tracer, trace
from continuation.archive import *
from problems.bifurcation import Cusp, ExponentialCosine
import continuation.archive.sweep
out = sys.argv[1]
os.makedirs(out, exist_ok=True)
os.chdir(out)
class Seen:
    target = 1.0
    def start(self): return np.zeros(2), 0.0
    def residual(self, y, lam): return y - lam
    def jacobian(self, y, lam): return np.eye(2), -np.ones(2)
    def observe(self, y, lam): return {"norm": float(np.abs(y).max()), "square": float(y @ y)}
trace(Cusp(), archive="finished.h5")
trace(Cusp(), archive="budget.h5", budget=Budget(steps=6))
trace(Cusp(), archive=PathLog("tangents.h5", tangents=True))
trace(Seen(), archive="observed.h5")
for name, rows in (("killed.h5", 3), ("killed_early.h5", 256)):
    pid = os.fork()
    if pid == 0:
        for i, _ in enumerate(Tracer(ExponentialCosine(4), observers=(PathLog(name, limits=Limits(rows=rows)),))):
            if i == 15: os.kill(os.getpid(), 9)
    os.waitpid(pid, 0)
with trace_many([Cusp(.4), Cusp(.9), Cusp(1.5)], archive="sweep.h5"): pass
with ThreadPoolExecutor(2) as ex, trace_many([Cusp(.4), Cusp(.9), Cusp(1.5)], ex, "pool.h5"): pass
merge(["finished.h5", "budget.h5"], "merged.h5")
export("finished.h5", "gzip.nc")
# a killed sweep: one path finished, one begun
pid = os.fork()
if pid == 0:
    with PathLog("killed_sweep.h5", limits=Limits(rows=3)) as log:
        for _ in Tracer(Cusp(), observers=(log,)): pass
        for i, _ in enumerate(Tracer(Cusp(.4), observers=(log,))):
            if i == 7: os.kill(os.getpid(), 9)
os.waitpid(pid, 0)
import json
told = {}
for f in sorted(os.listdir(".")):
    if f.endswith((".h5", ".nc")):
        with open_archive(f) as a:
            told[f] = {"paths": len(a), "points": a.points.size, "statuses": [p.status.name for p in a], "end": [p.steps[-1].lam if len(p.steps) else None for p in a], "sum": float(a.points["y"].sum())}
json.dump(told, open("told.json", "w"), indent=1)
