from ._edit_log import TreeEdit as TreeEdit
