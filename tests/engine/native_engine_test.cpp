#include "filasofia/engine/native_engine.h" // and nothing else

TEST_CASE("who makes a native engine needs its header alone")
{
    const auto engine = filasofia::engine::makeNativeEngine({.threads = 1});
    CHECK(engine != nullptr);
}
