//! FLAGRED: how close a multirotor is to losing control, told from its motor commands alone.
