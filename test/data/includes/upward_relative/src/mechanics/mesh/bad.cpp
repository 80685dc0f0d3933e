#include "../contact/gap.h"
