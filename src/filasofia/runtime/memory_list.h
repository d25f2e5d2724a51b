#pragma once

#include "filasofia/runtime/memory.h"

#include <vector>

namespace filasofia::runtime {

/// What the parts of a simulator remember; used between two steps.
class MemoryList {
public:
    /// Parts of the same name are told apart by their order.
    void add(Memory memory);
    [[nodiscard]] Memories save() const;
    /// Error if one of the parts cannot return to these copies.
    void check(const Memories& saved) const;
    void restore(const Memories& saved) const;

private:
    std::vector<Memory> all_;
};

} // namespace filasofia::runtime
