#include "io/image_io.h"
namespace dapple {}
