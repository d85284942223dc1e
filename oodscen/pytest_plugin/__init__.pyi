from ._driving import Drive as Drive
