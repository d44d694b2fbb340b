// volk's implementation (Arseny Kapoulkine, https://github.com/zeux/volk), compiled once.
#define VOLK_IMPLEMENTATION
#include <volk.h>
