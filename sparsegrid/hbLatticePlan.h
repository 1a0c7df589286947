#pragma once

#include <vector>

/// The places of one plane's samples, prepared by hbLatticeEvaluator::plan().
struct hbLatticePlan {
  std::vector<double> us, vs;
};

/// Memory that hbLatticeEvaluator::plane() uses again and again; one a thread.
struct hbLatticeWorkspace {};
