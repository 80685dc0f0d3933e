#include "study/search/assessment.h"
