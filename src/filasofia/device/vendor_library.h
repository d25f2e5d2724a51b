#pragma once

#include <memory>
#include <string>

namespace filasofia::device {

/// A vendor's shared library, opened at run time so that it is not needed to build.
class VendorLibrary {
public:
    /// `path` is the library's file; if empty, the system searches for `soname`. Throws an Error naming `object`.
    VendorLibrary(std::string object, const std::string& path, const char* soname);

    /// Looks up a function by name; throws an Error if the library has none of that name.
    template <class Function> void get(const char* name, Function*& out) const
    {
        out = reinterpret_cast<Function*>(find(name));
    }

private:
    [[nodiscard]] void* find(const char* name) const;

    std::string object_, path_;
    std::shared_ptr<void> handle_;
};

} // namespace filasofia::device
