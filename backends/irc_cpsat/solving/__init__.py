"""From a problem to an outcome: CP-SAT models of growing depth, solved objective by objective."""
