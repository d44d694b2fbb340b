#include "trace_cases.h"

namespace glint::app::test::trace_test {
INSTANTIATE_TEST_SUITE_P(Host, Trace, ::testing::Values("cpu"));

}  // namespace glint::app::test::trace_test
