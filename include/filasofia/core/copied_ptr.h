#pragma once

#include <memory>
#include <utility>

namespace filasofia {

/// A unique_ptr whose copy owns a copy of the object.
template <class T> class CopiedPtr : public std::unique_ptr<T> {
public:
    CopiedPtr() = default;
    CopiedPtr(std::unique_ptr<T> object) : std::unique_ptr<T>(std::move(object)) {} // NOLINT: as make_unique gives it
    CopiedPtr(const CopiedPtr& other) : std::unique_ptr<T>(other ? std::make_unique<T>(*other) : nullptr) {}
    CopiedPtr(CopiedPtr&&) noexcept = default;
    CopiedPtr& operator=(const CopiedPtr& other)
    {
        if (this != &other) *this = CopiedPtr(other);
        return *this;
    }
    CopiedPtr& operator=(CopiedPtr&&) noexcept = default;
    ~CopiedPtr() = default;
};

} // namespace filasofia
