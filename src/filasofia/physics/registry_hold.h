#pragma once

#include <mutex>

namespace filasofia::physics {

class PhysicsServer;

/// For tests: holds the lock that every caller of a server takes, except the stepping thread.
class RegistryHold {
public:
    explicit RegistryHold(PhysicsServer& server);

private:
    std::unique_lock<std::mutex> lock_;
};

} // namespace filasofia::physics
