"""Why a path ends: each function gives a `Verdict`, or None to continue."""

from __future__ import annotations

from attrs import frozen

from continuation.ends.closed_curve import same_ray
from continuation.ends.divergence import beyond_horizon, words
from continuation.ends.endgame import SingularLimit
from continuation.ends.target import ArcEnd, EndsAt
from continuation.evaluation.errors import EvaluationError
from continuation.kinks.through import Crossing
from continuation.point.projection import PathSolver
from continuation.predictors import Knot
from continuation.rejection import Rejected
from continuation.status import Status
from continuation.step.start import SingularStartError, StartError
from continuation.step.state import State


@frozen(eq=False)
class Verdict:
    """How a path ended.

    `particulars` follow the status' sentence. `limit`: a singular end. `rejected`: the last failures. `error`: bound of
    a component's error at a regular end.
    """

    status: Status
    particulars: str = ""
    limit: SingularLimit | None = None
    rejected: tuple[Rejected, ...] = ()
    error: float | None = None

    def __str__(self) -> str:
        return f"{self.status} {self.particulars}" if self.particulars else str(self.status)


INTERRUPTED = Verdict(Status.INTERRUPTED)


def abandoned(reason: str) -> Verdict:
    """The caller left the loop."""
    return Verdict(Status.ABANDONED, f"Given up: {reason}." if reason else "")


def raised(error: BaseException) -> Verdict:
    """A plug-in or observer raised."""
    return Verdict(Status.RAISED, f"It says: {sentence(error)}")


def sentence(error: BaseException) -> str:
    """An exception in one line."""
    try:
        text = str(error)
    except Exception as within:
        text = f"its text cannot be had ({type(within).__name__})"
    return " ".join(f"{type(error).__name__}: {text}".split())


def refused_start(error: StartError) -> Verdict:
    """The path cannot begin."""
    singular = isinstance(error, SingularStartError)
    return Verdict(Status.SINGULAR_START if singular else Status.START_NOT_ON_PATH, str(error))


def start_on_target(lam: float, target: float | None) -> Verdict | None:
    """The path ends where it begins."""
    return Verdict(Status.REACHED_TARGET, "The start lies on it.") if lam == target else None


def budget_spent(limit: str, state: State | None, rejected: tuple[Rejected, ...] = ()) -> Verdict | None:
    """The budget is exhausted at `limit`; mentions an asymptote in sight."""
    limit = limit or ("" if state is None else beyond_horizon(state.here.u))
    if not limit:
        return None
    seen = "" if state is None else words(state.divergence_monitor)
    seen = f" In sight, and not followed to its end: {seen[0].lower()}{seen[1:]}" if seen else ""
    return Verdict(Status.BUDGET_EXHAUSTED, f"Reached: {limit}.{seen}", rejected=rejected)


def predictor_failed(error: EvaluationError) -> Verdict:
    """The predictor failed."""
    return Verdict(Status.PREDICTOR_FAILED, f"It says: {error}.")


def singular_end(limit: SingularLimit) -> Verdict:
    """A limit on the target, out of reach of steps."""
    w = limit.winding_number
    power = f"|lam - target|^(1/{w})" if w > 1 else "lam - target"
    found = f"There it is a power series in {power}; error of the limit about {limit.error:.1g}."
    return Verdict(Status.REACHED_TARGET, found, limit)


def finished(residual_norm: float) -> Verdict:
    """The homotopy's finish found the end."""
    found = f"The homotopy's own finish found the end; the residual of H there is {residual_norm:.1e}."
    return Verdict(Status.REACHED_TARGET, found)


def no_step_left(h: float, minimum: float, rejected: tuple[Rejected, ...]) -> Verdict | None:
    """The step is below its minimum; the last rejection decides."""
    if h >= minimum:
        return None
    last = rejected[-1]
    status = Status.LEFT_DOMAIN if last.reason.leaves_domain else Status.STEP_TOO_SMALL
    return Verdict(status, f"Last reason: {last}.", rejected=rejected)


def arc_ended(end: ArcEnd, infinity: str, event: str) -> Verdict | None:
    """The verdict if an accepted arc ends the path, else None.

    `infinity`: how the path diverges, or "". `event`: name of the arc's last event.
    """
    if end.limit is not None:
        return singular_end(end.limit)
    if end.at is EndsAt.TARGET:
        return Verdict(Status.REACHED_TARGET, error=end.error)
    if end.at is EndsAt.EVENT:
        return Verdict(Status.STOPPED_AT_EVENT, f"It is: {event}.")
    if end.at is EndsAt.START:
        return Verdict(Status.CLOSED)
    if end.at is EndsAt.START_PARAMETER:
        return Verdict(Status.TURNED_BACK)
    return Verdict(Status.DIVERGED, infinity) if infinity else None


def behind_kink(kink: Crossing, solver: PathSolver, origin: Knot) -> Verdict | None:
    """The path ends in a kink: its start, a dead end, or unresolved."""
    if kink.onward is not None:
        return Verdict(Status.CLOSED) if same_ray(solver, origin, kink.onward) else None
    where = f"Switches that vanish there: {', '.join(map(str, kink.switches))}."
    return Verdict(Status.UNRESOLVED_KINK if kink.reason else Status.DEAD_END, f"{where} {kink.reason}".rstrip())
