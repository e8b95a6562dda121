# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The same window solve by GTSAM: projection factors, a prior on each landmark, Levenberg-Marquardt."""

import time
from typing import Any

import numpy as np

from benchmarks.speed.problem import WindowProblem
from benchmarks.speed.solver import Answer, Settings


class Gtsam:
    """Variants ORDERING/FACTORISATION/DAMPING.

    Ordering `poses` or `landmarks` (these are eliminated first), `COLAMD` or `METIS`; damping `diagonal` (relative, as
    Ceres does it) or `identity` (GTSAM's first choice). Timed are the construction of the optimiser and its iterations,
    in C++; graph and ordering are made beforehand.
    """

    def __init__(self) -> None:
        import gtsam

        self._gtsam = gtsam
        self._orderings: dict[str, Any] = {}

    def prepare(self, problem: WindowProblem) -> None:
        gtsam = self._gtsam
        self._problem = problem
        K = problem.camera.K
        intrinsics = gtsam.Cal3_S2(K[0, 0], K[1, 1], 0.0, K[0, 2], K[1, 2])
        pixel = gtsam.noiseModel.Isotropic.Sigma(2, problem.sigma_px)
        prior = gtsam.noiseModel.Isotropic.Sigma(3, problem.prior_sigma_m)
        self._poses = [gtsam.symbol("x", k) for k in range(problem.views)]
        self._points = [gtsam.symbol("l", j) for j in range(problem.landmarks)]
        self._graph, self._start = gtsam.NonlinearFactorGraph(), gtsam.Values()
        for x, T, pixels in zip(self._poses, problem.T_start, problem.pixels, strict=True):
            self._start.insert(x, gtsam.Pose3(np.linalg.inv(T)))
            for j, z in zip(self._points, pixels, strict=True):
                self._graph.add(gtsam.GenericProjectionFactorCal3_S2(z, pixel, x, j, intrinsics))
        for j, X in zip(self._points, problem.X0, strict=True):
            self._start.insert(j, X)
            self._graph.add(gtsam.PriorFactorPoint3(j, X, prior))
        self._orderings = {}

    def _ordering(self, kind: str) -> Any:
        gtsam = self._gtsam
        if kind not in self._orderings:
            if kind in ("COLAMD", "METIS"):
                by = gtsam.Ordering.OrderingType.COLAMD if kind == "COLAMD" else gtsam.Ordering.OrderingType.METIS
                self._orderings[kind] = gtsam.Ordering.CreateNonlinearFactorGraph(by, self._graph)
            else:
                self._orderings[kind] = gtsam.Ordering()
                first, last = (self._poses, self._points) if kind == "poses" else (self._points, self._poses)
                for key in (*first, *last):
                    self._orderings[kind].push_back(key)
        return self._orderings[kind]

    def _parameters(self, settings: Settings) -> Any:
        ordering, factorisation, damping = settings.variant.split("/")
        kinds = self._gtsam.LevenbergMarquardtParams
        parameters = kinds.CeresDefaults() if damping == "diagonal" else kinds.LegacyDefaults()
        parameters.setlambdaInitial(settings.damping)
        parameters.setLinearSolverType(factorisation)
        parameters.setOrdering(self._ordering(ordering))
        parameters.setRelativeErrorTol(settings.tolerance)
        parameters.setAbsoluteErrorTol(0.0)
        parameters.setErrorTol(0.0)
        parameters.setMaxIterations(settings.max_iterations)
        return parameters

    def solve(self, settings: Settings, seconds: float) -> tuple[float, int]:
        parameters = self._parameters(settings)
        spent, solves = 0.0, 0
        while solves == 0 or spent < seconds:
            begin = time.process_time()
            optimizer = self._gtsam.LevenbergMarquardtOptimizer(self._graph, self._start, parameters)
            self._values = optimizer.optimize()
            spent += time.process_time() - begin
            solves += 1
        return spent / solves, optimizer.iterations()

    def answer(self) -> Answer:
        X = np.stack([self._values.atPoint3(j) for j in self._points])
        return Answer(X=X, T=np.stack([np.linalg.inv(self._values.atPose3(x).matrix()) for x in self._poses]))
