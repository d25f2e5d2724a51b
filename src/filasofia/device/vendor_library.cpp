#include "filasofia/device/vendor_library.h"

#include "filasofia/core/error.h"

#include <dlfcn.h>

#include <utility>

namespace filasofia::device {

VendorLibrary::VendorLibrary(std::string object, const std::string& path, const char* soname)
    : object_(std::move(object)), path_(path.empty() ? soname : path)
{
    // Never closed, because a vendor's library may have threads that outlive the device.
    void* handle = dlopen(path_.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle) {
        const char* why = dlerror();
        fail(object_, ": library '", path_, "' cannot be opened: ", why ? why : "the system gave no reason");
    }
    handle_ = std::shared_ptr<void>(handle, [](void*) {});
}

void* VendorLibrary::find(const char* name) const
{
    void* function = dlsym(handle_.get(), name);
    if (!function) fail(object_, ": library '", path_, "' has no function ", name);
    return function;
}

} // namespace filasofia::device
