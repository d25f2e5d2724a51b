#pragma once

#include <memory>
#include <string>

namespace filasofia::device {

/// A vendor's shared library, opened at run time so that nobody needs it to build.
class VendorLibrary {
public:
    /// `path`: where it is; empty: the system's place for `soname`. Throws an Error naming `object`.
    VendorLibrary(std::string object, const std::string& path, const char* soname);

    /// A function of it by name; Error where it has none.
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
