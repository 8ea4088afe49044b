"""Statuses: of one outcome, and of records of many."""

from itertools import product

import numpy as np

from sinuous.answer.status import Status, status_of, statuses_of
from sinuous.kernels.tables import BOUND, CLEARANCE, CODE, RATE_BOUND, RECORD_WIDTH, SELF_CLEARANCE, Outcome
from tests.cases import with_each

CASES = list(product(range(RATE_BOUND + 1), (0.0, 1.0), (-1.0, 0.0, np.inf), (-1.0, 2.0)))


def test_records_have_the_statuses_of_their_outcomes() -> None:
    records = np.zeros((len(CASES), RECORD_WIDTH + 9))
    for column, values in zip((CODE, BOUND, CLEARANCE, SELF_CLEARANCE), zip(*CASES, strict=True), strict=True):
        records[:, column] = values
    found = statuses_of(records)
    for record, status in zip(records, found, strict=True):
        assert status is status_of(Outcome.from_record(np.zeros((3, 3)), record[:RECORD_WIDTH].tolist()))
    assert set(found) == set(Status) - {Status.START_BLOCKED}  # of motions alone
    assert len(statuses_of(records[:0])) == 0


@with_each("status", Status)
def test_every_status_has_a_sentence(status: Status) -> None:
    assert status.sentence
