#include "mechanics/contact/rigid_contact.h"
