#pragma once

#include "filasofia/linalg/node_array.h"

namespace filasofia {
class WorkerPool;
}

namespace filasofia::linalg {

/// A symmetric positive definite matrix over nodes in single precision, of which only the product is known.
class NodeOperator {
public:
    virtual ~NodeOperator() = default;
    /// q = A p; returns p . q
    virtual double multiply(const NodeArray& p, NodeArray& q, WorkerPool& pool) = 0;
};

} // namespace filasofia::linalg
