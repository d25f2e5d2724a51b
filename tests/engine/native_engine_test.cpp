#include "filasofia/engine/native_engine.h" // and nothing else

namespace native_engine_test {

TEST_CASE("making a native engine needs only its header")
{
    const auto engine = filasofia::engine::makeNativeEngine({.threads = 1});
    CHECK(engine != nullptr);
}

} // namespace native_engine_test
